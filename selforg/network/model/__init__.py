"""What a network is made of, and its packed form for compiled code."""
