"""The examples run, each where its framework is installed."""
