"""What a study shows: errors against time, growth with size, who is first where."""
