"""Runs in processes of their own: messages, the process, and the pool that shares them."""
