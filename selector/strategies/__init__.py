"""The decision strategies that ship with the project; importing a module registers its strategy."""

from selector.strategies import fixed as fixed
from selector.strategies import max_score as max_score
from selector.strategies import policy as policy
from selector.strategies import random_choice as random_choice
from selector.strategies.bandits import discounted_ucb as discounted_ucb
from selector.strategies.bandits import epsilon_greedy as epsilon_greedy
from selector.strategies.bandits import exp3 as exp3
from selector.strategies.bandits import gaussian_thompson as gaussian_thompson
from selector.strategies.bandits import lin_ucb as lin_ucb
from selector.strategies.bandits import linear_thompson as linear_thompson
from selector.strategies.bandits import sliding_window_ucb as sliding_window_ucb
from selector.strategies.bandits import ucb1 as ucb1
