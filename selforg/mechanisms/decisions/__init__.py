"""Decision mechanisms, which give rows a value and a state."""
