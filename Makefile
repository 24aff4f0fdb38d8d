# The environment of the repository if there is one, else the one that is active.
BIN := $(if $(wildcard .venv/bin/python),.venv/bin/,)
BENCHMARKS := benchmarks.floor benchmarks.selforg benchmarks.network benchmarks.stack benchmarks.tick benchmarks.border \
	benchmarks.costs benchmarks.walls benchmarks.threads benchmarks.switching benchmarks.document benchmarks.required

.PHONY: check lint test quick durations docs golden examples newest long soak mutants learning bench dist

check: lint test  ## all that CI asks for

lint:
	$(BIN)ruff check .
	$(BIN)ruff format --check .
	$(BIN)mypy
	$(BIN)lint-imports

test:  ## the gate
	$(BIN)python -m pytest -n 2 --dist loadfile

quick:  ## lint and types of what changed since the last push, and the tests of its folders
	$(BIN)python -m tests.rings.quick

durations:  ## CPU and wall seconds of each test file of the gate into tests/durations.csv, minutes into CONTRIBUTING.md
	$(BIN)python -m tests.rings.durations

docs:  ## the site, build/site/html/index.html, from docs/ and the code; warnings are errors, no network is needed
	$(BIN)python -m docs.site.replays build/site/replays
	NUMBA_DISABLE_JIT=1 $(BIN)python -W ignore::RuntimeWarning -m docs.site.build

golden:  ## numbers of the original implementation, as the tests compare them: which agree, and what is set aside
	$(BIN)python -m tests.golden

examples:  ## every example in an environment of its own, with its framework; FRAMEWORKS=tianshou for some
	$(BIN)python -m tests.examples .frameworks $(FRAMEWORKS)

newest:  ## the examples with today's newest versions of the frameworks, in further environments
	$(BIN)python -m tests.examples --newest .frameworks/newest $(FRAMEWORKS)

long:  ## the tests that take long, with a table; records in tests/long.json of which sources they are green
	$(BIN)python -m tests.rings.long

soak:  ## all long random tests side by side, within half an hour on two CPUs: what was tried, what survived, seconds
	$(BIN)python -m tests.soak

mutants:  ## random faults in the core, each with the tests of its folder: lists those that no test notices
	$(BIN)python -m tests.mutants --random $(or $(N),30) --seed $(or $(SEED),0)

dist:  ## sdist and wheel of the last commit in dist/, the same bytes on any machine, checked; without the network
	$(BIN)python -m tests.releases.build

learning:  ## a small version of docs/choosing.md, some minutes; fails where its main claims do not hold
	$(BIN)python -m docs.comparison.write_choosing docs/comparison/learning.yaml

bench:  ## figures into benchmarks/results.json and docs/benchmarks.md; fails where a ratio became worse beyond its noise
	status=0; for module in $(BENCHMARKS); do $(BIN)python -m $$module || status=1; done; exit $$status

