"""The evaluation's side: starts a guest, asks it for actions and judges its answers. Begin with `guest.Guest`."""
