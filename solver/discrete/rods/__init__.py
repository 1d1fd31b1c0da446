"""Parallel rods that rub on a support, or on each other."""
