"""What our robots share: exploring, routes, manipulation, carrying, messages and task allocation."""
