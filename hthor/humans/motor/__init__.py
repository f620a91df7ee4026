"""How a person walks, stands, approaches and uses their hands."""
