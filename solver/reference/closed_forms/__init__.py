"""What is known without a mesh: closed forms, and curves that plots draw of them."""
