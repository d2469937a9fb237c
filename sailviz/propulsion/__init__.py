"""The force of one device, nothing else: solar sails, electric sails, the plasma brake, thrusters."""
