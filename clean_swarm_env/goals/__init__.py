"""The goals of self-organisation as environments: scenes as batches of worlds that all borders can step."""
