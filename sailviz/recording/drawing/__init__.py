"""What a recording shows: views, entities, curves and cameras, drawn from the arrays of a run."""
