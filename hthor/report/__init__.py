"""What people read about runs: `analysis` computes it, `drawing` and `html` draw it, `page` and `terminal` show it."""
