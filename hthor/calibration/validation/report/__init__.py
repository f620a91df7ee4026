"""The validation report: how well a human model reproduces the published study."""
