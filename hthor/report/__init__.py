"""What people read about runs: `analysis` computes, `drawing` and `html` draw, `page` and `terminal` present."""
