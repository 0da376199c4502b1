"""The simulated chair: drives a plan, records what happened, judges it."""
