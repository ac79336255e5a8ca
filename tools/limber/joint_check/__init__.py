"""By hand, with the drives off: is each joint its own motor's, and does it turn the right way?"""
