"""Visibility, detections and range scans."""
