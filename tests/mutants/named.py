"""Mutants of core lines by hand, each with the tests that have to notice it."""

from tests.mutants.mutant import Mutant

BALCH, SPACE = "selforg/gradients/pair.py", "selforg/space.py"
FERNANDEZ, GE = "selforg/mechanisms/repulsion.py", "selforg/mechanisms/chemotaxis.py"
COLLISIONS, PHYSICS = (
    "clean_swarm_env/physics/collisions.py",
    "tests/clean_swarm_env/physics/test_collisions.py::test_a_pair_at_the_distance_itself_is_not_closer",
)
UCB, BANDITS = "selector/strategies/bandits/upper_confidence.py", "tests/selector/strategies/test_bandits.py"
JOURNAL, WRITING = "train/running/finished_runs.py", "selector/documents/writing.py"
ENDINGS, SEARCH = (
    "tests/train/cli/test_endings.py::test_what_is_promised_to_be_kept_is_on_the_disk_before_it_counts",
    "selforg/network/planning/search.py",
)
OF_FORMULAS, OF_SPACE, OF_PLANS = (
    ("tests/selforg/mechanisms/test_formulas.py",),
    ("tests/selforg/test_space.py",),
    ("tests/selforg/network/planning/test_planner.py",),
)
MUTANTS = (
    Mutant(
        "repulsion of Balch at no clearance",
        BALCH,
        "if pair.clearance <= 0.0 or np.isinf(pair.diffusion):",
        "if pair.clearance < 0.0 or np.isinf(pair.diffusion):",
        OF_FORMULAS,
    ),
    Mutant(
        "repulsion of Fernandez at no clearance",
        FERNANDEZ,
        "if clearance <= 0.0:",
        "if clearance < 0.0:",
        OF_FORMULAS,
    ),
    Mutant(
        "repulsion of Ge at no clearance",
        GE,
        "    if pair.clearance <= 0.0:\n        return np.inf, 0.0",
        "    if pair.clearance < 0.0:\n        return np.inf, 0.0",
        OF_FORMULAS,
    ),
    Mutant(
        "attraction of Balch at its diffusion",
        BALCH,
        "    if pair.clearance <= pair.diffusion:\n        return pair.clearance / pair.diffusion",
        "    if pair.clearance < pair.diffusion:\n        return pair.clearance / pair.diffusion",
        OF_FORMULAS,
    ),
    Mutant("half a torus, forwards", SPACE, "if delta > half:", "if delta >= half:", OF_SPACE),
    Mutant("half a torus, backwards", SPACE, "if delta < -half:", "if delta <= -half:", OF_SPACE),
    Mutant("end of a torus", SPACE, "coordinate >= extent):", "coordinate > extent):", OF_SPACE),
    Mutant(
        "sample at the distance",
        COLLISIONS,
        "c.samples[world, k] += now < c.squares[k]",
        "c.samples[world, k] += now <= c.squares[k]",
        (PHYSICS,),
    ),
    Mutant(
        "event at the distance",
        COLLISIONS,
        "c.events[world, k] += now < c.squares[k] <= was",
        "c.events[world, k] += now <= c.squares[k] <= was",
        (PHYSICS,),
    ),
    Mutant(
        "event after the distance",
        COLLISIONS,
        "c.events[world, k] += now < c.squares[k] <= was",
        "c.events[world, k] += now < c.squares[k] < was",
        (PHYSICS,),
    ),
    Mutant(
        "contact at the distance",
        COLLISIONS,
        "if now < c.squares[0]:",
        "if now <= c.squares[0]:",
        (PHYSICS,),
    ),
    Mutant(
        "totals of groups without rewards",
        UCB,
        "self.totals[touched] *= self.discount",
        "self.totals *= self.discount",
        (BANDITS,),
    ),
    Mutant(
        "counts of groups without rewards",
        UCB,
        "self.counts[touched] *= self.discount",
        "self.counts *= self.discount",
        (BANDITS,),
    ),
    Mutant(
        "discount of totals",
        UCB,
        "        self.totals[touched] *= self.discount\n",
        "",
        (BANDITS,),
    ),
    Mutant("fsync of the journal", JOURNAL, "                os.fsync(file.fileno())\n", "", (ENDINGS,)),
    Mutant("fsync of whole files", WRITING, "                os.fsync(file.fileno())\n", "", (ENDINGS,)),
    Mutant(
        "whole files",
        WRITING,
        'path.with_name(f".{path.name}.{os.getpid()}.part")',
        "path",
        (ENDINGS,),
    ),
    Mutant(
        "transactions that write",
        "selector/store/knowledge_store.py",
        'connection.execute(f"BEGIN {kind}")',
        'connection.execute("BEGIN")',
        ("tests/selector/store/test_processes.py",),
    ),
    Mutant(
        "one transaction for an update",
        "selector/store/knowledge_store.py",
        '            connection.execute(f"BEGIN {kind}")\n',
        "",
        ("tests/selector/store/test_processes.py",),
    ),
    Mutant(
        "the cheapest way to a state",
        SEARCH,
        "best.get(following, reached) < reached:",
        "best.get(following, reached) > reached:",
        OF_PLANS,
    ),
    Mutant("cost of a plan", SEARCH, "reached = (cost + step.cost,", "reached = (cost + 1,", OF_PLANS),
    Mutant(
        "goal when a state is taken",
        SEARCH,
        "                if following in opened or",
        "                if is_met(task.goal, *following):\n"
        "                    return self.found((*sequence, step.action))\n"
        "                if following in opened or",
        OF_PLANS,
    ),
)
