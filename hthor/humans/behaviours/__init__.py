"""What a person does next: follow a message, deliver, carry."""
