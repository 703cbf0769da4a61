"""analyze: what must be differentiated, what must be recorded, and where recorded values come back."""
