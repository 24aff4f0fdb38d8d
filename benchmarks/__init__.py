"""Speed, beside what it is to be compared with; `make bench` runs all of them."""
