# The environment of the repository if there is one, else the one that is active.
BIN := $(if $(wildcard .venv/bin/python),.venv/bin/,)
BENCHMARKS := benchmarks.floor benchmarks.selforg benchmarks.network benchmarks.stack benchmarks.tick benchmarks.border \
	benchmarks.costs benchmarks.switching benchmarks.document benchmarks.required

.PHONY: check lint test golden examples soak bench

check: lint test  ## all that CI asks for

lint:
	$(BIN)ruff check .
	$(BIN)ruff format --check .
	$(BIN)mypy
	$(BIN)lint-imports

test:
	$(BIN)python -m pytest -n 2 --dist loadfile

golden:  ## numbers of the original implementation, beside this checkout
	$(BIN)python -m tests.golden

examples:  ## every example in an environment of its own, with its framework; FRAMEWORKS=tianshou for some
	$(BIN)python -m tests.examples .frameworks $(FRAMEWORKS)

soak:  ## all long random tests side by side, within half an hour on two CPUs: what was tried, what survived, seconds
	$(BIN)python -m tests.soak

bench:  ## figures into benchmarks/results.json and docs/benchmarks.md; fails where a ratio became worse beyond its noise
	status=0; for module in $(BENCHMARKS); do $(BIN)python -m $$module || status=1; done; exit $$status

