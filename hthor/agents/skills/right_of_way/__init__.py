"""Getting past other bodies: people (`passing`) and robots (`yielding`)."""
