"""`hthor agent check`: does an agent keep to the contract?"""
