"""The largest load under which slip ceases, as linear programs."""
