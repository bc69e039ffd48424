"""What a result is written as: tables, CSV, JSON, netCDF, figures. Knows rows and panels, no physics."""
