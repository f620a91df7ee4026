"""What a person notices of what is in view."""
