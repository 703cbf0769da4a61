"""Types of library functions, by the name that their rule or their expansion gives them."""
