"""Robots as nodes of ROS 2: `python -m examples.ros robot|world|swarm MISSION`."""
