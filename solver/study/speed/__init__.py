"""What a study shows: errors against time, and who is first at which size."""
