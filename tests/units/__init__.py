"""What is made for one program."""
