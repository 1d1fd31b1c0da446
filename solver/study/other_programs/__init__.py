"""Results and problems that go to other programs, or come from them."""
