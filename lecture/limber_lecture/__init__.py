"""Experiments: each compares numbers a formula predicts with numbers measured independently."""
