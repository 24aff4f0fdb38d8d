"""The registry of mechanisms: the name of the class is the name by which configurations find a mechanism."""

from selforg.mechanisms.base import Mechanism
from selforg.registry import Registry

MECHANISMS: Registry[Mechanism] = Registry("mechanism")
