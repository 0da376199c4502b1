"""narrows: plan how a wheelchair with a real body gets through narrow places."""
