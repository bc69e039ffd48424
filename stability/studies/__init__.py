"""What can be asked: one file a question, and of its name."""
