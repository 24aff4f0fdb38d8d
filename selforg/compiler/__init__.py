"""How functions are compiled and how arrays reach them."""
