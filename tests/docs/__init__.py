"""What the documents say is so: their blocks print what they show, their tables and pictures are made of what runs."""
