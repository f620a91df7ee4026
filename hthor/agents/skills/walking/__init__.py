"""What robots do in tasks where a body has to go to a landmark: walk there, or tell the person who walks."""
