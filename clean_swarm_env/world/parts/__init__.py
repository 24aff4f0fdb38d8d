"""What tasks consist of: measures, things, what they show, and what their parts have to return."""
