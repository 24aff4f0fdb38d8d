# The environment of the repository if there is one, else the one that is active.
BIN := $(if $(wildcard .venv/bin/python),.venv/bin/,)
BENCHMARKS := benchmarks.floor benchmarks.selforg benchmarks.network benchmarks.stack

.PHONY: check lint test bench clean-cache

check: lint test  ## all that CI asks for

lint:
	$(BIN)ruff check .
	$(BIN)ruff format --check .
	$(BIN)mypy
	$(BIN)lint-imports

test:
	$(BIN)python -m pytest

bench:
	for module in $(BENCHMARKS); do $(BIN)python -m $$module || exit 1; done

clean-cache:  ## compiled code of a kernel whose callees, in another file, have changed
	find . -name '*.nb[ic]' -not -path './.venv/*' -delete
