# Installation and export of the libraries and programs.
