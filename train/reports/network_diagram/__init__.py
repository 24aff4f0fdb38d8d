"""Diagrams of behaviour networks: content (boxes and links), layout (positions), picture (Matplotlib)."""

from train.reports.network_diagram.content import configuration_panels as configuration_panels
from train.reports.network_diagram.content import robot_panels as robot_panels
from train.reports.network_diagram.picture import draw_panels as draw_panels
from train.reports.network_diagram.picture import save_picture as save_picture
