"""The live views: each is a function of the page's state and says when it applies."""
