"""Learners that compare whole missions of the members of a population: evolution strategies and design by races."""
