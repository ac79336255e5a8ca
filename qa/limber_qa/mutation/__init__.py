"""`limber dev mutation`: do the tests notice a fault that was put into the code on purpose?"""
