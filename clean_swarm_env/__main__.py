"""The command line, as the script `clean-swarm` and as `python -m clean_swarm_env`."""

from clean_swarm_env.siblings import call


def command_line() -> None:
    """Run the command line."""
    call("train.cli", "main")


if __name__ == "__main__":
    command_line()
